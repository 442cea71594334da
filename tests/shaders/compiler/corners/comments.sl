/* a /* comment in a comment, and "quotes", and // more */
surface /* here, too */ comments ( ) // and here
{ string a = "/* not a comment */ // nor this"; Ci = color (0, a != "", 0); } ;
